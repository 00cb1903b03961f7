<!DOCTYPE html>
<html lang="en">
<head>
<title>hello_node.py</title>
</head>
<body></body>
</html>
