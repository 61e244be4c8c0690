# Tests of src/core, src/sensor and src/codec.
sweepcast_test(core/bytes)
sweepcast_test(core/cloud)
sweepcast_test(core/crc32)
sweepcast_test(core/trig)
sweepcast_test(sensor/spherical_grid)
