# Tests of src/lab.
sweepcast_test(lab/distortion sweepcast_measure)
if(SWEEPCAST_APPS)
  sweepcast_test(lab/bench sweepcast_bench sweepcast_app)
endif()
if(SWEEPCAST_WITH_DRACO)
  sweepcast_test(lab/draco sweepcast_bench)
endif()
