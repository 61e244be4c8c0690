// io/cloud_file
