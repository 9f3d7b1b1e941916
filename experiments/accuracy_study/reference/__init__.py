"""The field of a case from nothing of the package but the definitions of the slab and the source."""
