# Targets for src/io.
