"""Finding scripts of a class with common passages that few others have: pure functions of sources and commands.

`tokens` makes sources alike that differ in names, values, comments and layout only. `fingerprints` chooses what of
that is compared (winnowing: Schleimer, Wilkerson, Aiken 2003). `ranking` counts what is shared by few, `places`
says where that is, and `commands` tells whether two scripts drove alike.
"""
