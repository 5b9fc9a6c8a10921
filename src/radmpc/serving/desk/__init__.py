"""What lies on the desk: documents, plans, searches and flights, and the calls that move them."""
