// Variant in which reflection rays march through maps: `map` stands for the march of the method that has them.

#import map
