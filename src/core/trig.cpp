// core/trig
