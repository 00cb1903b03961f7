"""Requests, before a resource or a page sees them: bounds, headers, log lines, who asks, and in which language."""
