# Targets for src/codec.
