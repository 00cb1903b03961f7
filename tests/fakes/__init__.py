"""Hand-written stand-ins for what the service is built from."""
