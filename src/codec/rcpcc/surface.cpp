// codec/rcpcc/surface
