// A library beside middle.
