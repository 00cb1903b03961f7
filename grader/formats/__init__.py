"""Files as people hand them in and take them home: spreadsheets (`sheets`), packages of ROS 2 (`packages`).

Both read hostile bytes within fixed bounds and return contracts.
"""
