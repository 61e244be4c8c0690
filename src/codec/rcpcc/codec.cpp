// codec/rcpcc/codec
