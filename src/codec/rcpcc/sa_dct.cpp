// codec/rcpcc/sa_dct
