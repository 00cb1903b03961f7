"""Message, service and action classes, built from their definitions when a script asks for them, and their CDR."""
