"""What resources and pages share: bounds of requests, headers, who asks, in which language; compressed answers."""
