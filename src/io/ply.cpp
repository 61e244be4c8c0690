// io/ply
