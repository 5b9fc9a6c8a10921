"""What tests of the referee share is imported from this folder, from those below it too."""
