// io/sweep_reader
