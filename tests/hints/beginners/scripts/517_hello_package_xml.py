<?xml version="1.0"?>
<package format="3">
  <name>hello</name>
  <version>0.0.0</version>
</package>
