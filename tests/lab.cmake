# Tests of src/lab.
