"""What is proven about placements on curves by polynomials in the places."""
