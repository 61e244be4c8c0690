// io/pcd
