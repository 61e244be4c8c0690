# Targets for src/link.
sweepcast_fuzz(link_trace sweepcast_link_model)
if(SWEEPCAST_WITH_LINK)
  sweepcast_fuzz(link_fragment sweepcast_link)
endif()
