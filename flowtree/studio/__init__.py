"""The studio: a local web page to arrange, scribble, draw and paint, and to watch the tree grow."""
