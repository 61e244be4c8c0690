// sensor/spherical_grid
