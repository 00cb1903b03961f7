"""One module per version, in order. New tables are made from `grader.store.tables`, not by these."""
