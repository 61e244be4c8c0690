// codec/rcpcc/unfit
