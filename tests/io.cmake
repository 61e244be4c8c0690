# Tests of src/io.
sweepcast_test(io/bin sweepcast_io)
sweepcast_test(io/pcd sweepcast_io)
sweepcast_test(io/ply sweepcast_io)
sweepcast_test(io/cloud_file sweepcast_io)
sweepcast_test(io/sweep_file sweepcast_io)
sweepcast_test(io/sweep_failure sweepcast_io)
sweepcast_test(io/inputs sweepcast_app)
