// A library at the bottom.
