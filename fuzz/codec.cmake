# Targets for src/codec.
sweepcast_fuzz(frame)
