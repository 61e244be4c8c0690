// codec/rcpcc/occupancy
