"""Changes of a script's own text at nodes of its syntax tree; everything else stays as its author wrote it.

`tree` finds the text of a node and makes edits of it. A tree is only read here, never compiled or run. That of a
student's file comes from the jail, that of a trusted file from `ParsedScript.parsed`.
"""
