"""Launch files in XML and YAML, and substitutions in a text, such as ``$(var name)``."""
