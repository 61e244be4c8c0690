# The examples, built against an installed tree.
