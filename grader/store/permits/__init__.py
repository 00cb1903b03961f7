"""Scale-out on PostgreSQL: Procrastinate's jobs as permits to grade.

Whatever makes a row ``queued`` defers one job in the same transaction. A job is a *permit*: whoever runs it
claims the row that is due first, not the row it was made for, so that priorities and turns hold although rows
change places after their jobs were deferred. There are as many permits as rows that wait. A surplus permit finds
nothing and ends; a missing one is made up for by the sweep in every worker's heart (`announcer.mend`). A slot that
goes on to the next row without being given a permit uses one up itself (`announcer.claimed`).

So the queue holds nothing that matters: losing all its tables costs one sweep. This package is imported on
PostgreSQL only.
"""
