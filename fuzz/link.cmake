# Targets for src/link.
if(SWEEPCAST_WITH_LINK)
  sweepcast_fuzz(link_fragment sweepcast_link)
endif()
