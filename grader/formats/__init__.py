"""Formats of files: spreadsheets (`sheets`), packages of ROS 2 (`packages`), pictures (`png`), `interfaces`.

The first two are what people hand in: they read hostile bytes within fixed bounds and return contracts.
"""
