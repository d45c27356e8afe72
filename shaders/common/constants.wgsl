// Numbers that several files need.

const PI = 3.14159265358979f;
const TAU = 6.28318530717959f;
// The first coefficient of the function 1.
const SQRT_4PI = 3.5449077f;
// The least normal number.
const SMALLEST = 1.17549435e-38f;
// Beyond everything, and finite.
const ENDLESS = 3.4e38f;
// From 1 to the next larger number.
const EPSILON = 1.1920929e-7f;
