"""Substitutions in a text, such as ``$(var name)``. Launch files in XML and YAML are not read here."""
