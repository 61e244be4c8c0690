# Targets for src/io.
sweepcast_fuzz(bin sweepcast_io)
sweepcast_fuzz(pcd sweepcast_io)
sweepcast_fuzz(ply sweepcast_io)
sweepcast_fuzz(sweep_file sweepcast_io)
