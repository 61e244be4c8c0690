# Tests of the link in virtual time and of the bitrate strategies.
sweepcast_test(link/trace sweepcast_link_model)
sweepcast_test(link/link_model sweepcast_link_model)
