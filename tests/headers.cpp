// Nothing: a library must have a source, and this one is there for its precompiled headers.
