// io/sweep_writer
