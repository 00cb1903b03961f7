"""What the service says about itself to whoever runs it: log lines and measurements, never student's text."""
