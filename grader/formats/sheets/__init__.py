"""Tables as teachers carry them: class lists that come in, gradebooks that go out.

`reading` turns the bytes of a spreadsheet or a CSV file into rows of text, `roster` finds the people in them, and
`writing` makes workbooks.
"""
