"""Scripts as beginners write them, and the hint that each must get."""
