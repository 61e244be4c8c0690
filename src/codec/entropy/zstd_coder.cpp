// codec/entropy/zstd_coder
