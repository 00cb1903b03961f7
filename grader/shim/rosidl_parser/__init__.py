"""The part of rosidl_parser that message classes refer to: their `SLOT_TYPES`."""
