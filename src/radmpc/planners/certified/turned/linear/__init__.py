"""The linear programs of groups between half-spaces: what they ask for, and which are kept warm."""
