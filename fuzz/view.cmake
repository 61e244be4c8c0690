# Targets for src/view.
sweepcast_fuzz(view_client sweepcast_view)
