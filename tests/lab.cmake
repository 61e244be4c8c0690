# Tests of src/lab.
sweepcast_test(lab/distortion sweepcast_measure)
