// io/file
