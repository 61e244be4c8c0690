// io/bin
