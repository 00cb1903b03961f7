"""The HTTP interface, one router per resource. Knows store and contracts; `api` puts it together."""
