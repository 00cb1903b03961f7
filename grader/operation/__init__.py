"""What an operator sets and watches: settings, log lines and measurements, never a student's text."""
